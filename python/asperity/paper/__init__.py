"""The simulations of [WL19], each with the numbers it is checked against."""
