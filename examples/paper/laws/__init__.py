"""§2 and §3 of [WL19]: sets, cones, and the force laws made of them."""
