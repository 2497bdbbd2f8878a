"""What the language model learns to write programs from: a corpus, its check, the training."""
