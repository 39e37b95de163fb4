"""Tables as text, in spreadsheets and in memory, and what one seems to be."""
