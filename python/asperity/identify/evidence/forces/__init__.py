"""Forces over sliding directions: samples, their means, starts, defects, errors they share."""
