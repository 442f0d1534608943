"""Charts, 3-D scenes, number formats and the style of plots, without any reference to robots.

Input: curves, surfaces and numbers. Output: SVG, PNG, scenes for the browser, text.
"""
