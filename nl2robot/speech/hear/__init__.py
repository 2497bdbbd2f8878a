"""From sound to words, and whether to believe them."""
