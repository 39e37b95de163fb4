"""Models of reservoirs, direction sets and contact patches, and their coordinates."""
