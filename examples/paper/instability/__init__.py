"""§4 of [WL19]: instability caused by friction."""
