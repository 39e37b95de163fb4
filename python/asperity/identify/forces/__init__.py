"""From records to forces over the sliding direction: zero, turns, filters, means, measured sets."""
