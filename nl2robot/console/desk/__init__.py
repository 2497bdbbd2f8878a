"""The operator's page: talk, review, approve, watch."""
