"""From text to sound, one after the other, silent at once."""
