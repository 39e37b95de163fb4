"""Synthetic measurements behind the figures of §5."""
