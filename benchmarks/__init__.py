"""How fast the library is: against a yardstick, against the machine, and over the size of a scene."""
