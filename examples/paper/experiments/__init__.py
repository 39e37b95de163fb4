"""§5 of [WL19]: experiments, with synthetic data."""
