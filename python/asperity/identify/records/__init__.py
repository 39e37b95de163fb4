"""What a tribometer wrote: text, tables, units, runs, calibration, configuration."""
