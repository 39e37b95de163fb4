"""Critical directions and rotations: where the condition for stability changes its sign."""
