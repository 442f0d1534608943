"""Realistic mistakes, put into the models one at a time, and what the suite notices."""
