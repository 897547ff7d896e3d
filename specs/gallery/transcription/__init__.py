"""Reads specs and transcribes them with CasADi, apart from the compiler of this project."""
