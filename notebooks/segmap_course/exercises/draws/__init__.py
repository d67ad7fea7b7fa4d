"""Cases of the exercises, drawn from a seed."""
