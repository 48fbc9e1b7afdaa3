"""The claims of a certificate, one kind a file: each a function from what is certified to its questions."""
