"""How the pin slides: motion from columns, velocities from positions, stretches without rest."""
