"""Language: text -> plan -> Python program, and plan -> plain words."""
