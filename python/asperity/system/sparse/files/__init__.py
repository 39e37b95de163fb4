"""Matrices of finite-element codes from their files."""
