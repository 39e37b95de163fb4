"""One file for each family of sets that are made from lengths, points or samples."""
