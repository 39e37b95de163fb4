"""From forces to sets: models, least squares, uncertainty, comparison of models."""
