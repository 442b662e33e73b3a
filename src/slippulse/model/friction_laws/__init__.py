"""Laws of friction: one module each. `slippulse.model.friction` lists them."""
