"""Laws of friction, which `slippulse.model.friction` lists."""
