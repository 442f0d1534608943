"""Families of checks of the program that are on their way to become tests."""
