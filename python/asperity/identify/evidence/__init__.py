"""What a law follows from: forces over sliding directions, wrenches and twists, paths."""
