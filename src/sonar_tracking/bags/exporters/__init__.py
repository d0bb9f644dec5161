"""Bags for other programs: tables and charts."""
