"""Wrenches and twists of contact patches."""
