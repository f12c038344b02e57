"""Parts of tools/ray-sequence: scenes as POV-Ray text, the camera's path, rendering, and what a sensor does to the light."""


class Refused(Exception):
    """One line that says what is wrong."""
