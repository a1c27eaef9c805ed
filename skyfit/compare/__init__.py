"""The same sky through every model."""

from .figures import compare_skies as compare_skies
