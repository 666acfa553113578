"""The laws that ship with grainlaw, one file each, registered through the same entry points as anybody's."""

if __name__ == "plugins":
    raise ImportError("import grainlaw.plugins, not plugins")
