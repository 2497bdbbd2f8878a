"""What a person is shown before a program may run: check, policy, dry run, risks."""
