"""Campaign files (TOML): their schema, and errors that name file and key.

Angles are in degrees here, and only here: the keys say so, as they say every other unit.
"""

from .load import load_atmosphere as load_atmosphere, load_campaign as load_campaign
