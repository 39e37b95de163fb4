"""The estimator: descent, losses, covariance from what differs between clusters."""
