"""From picture to picture: the mark is followed, lost and found; repeated pictures."""
