"""What is asked of a scene apart from its run: equilibria, contacts, closest bobs, passages."""
