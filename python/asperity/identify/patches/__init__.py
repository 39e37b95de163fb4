"""Laws of contact patches from pairs of wrench and twist."""
