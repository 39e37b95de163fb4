"""Losses, normal equations summed over the samples, Levenberg and Marquardt's descent, starts."""
