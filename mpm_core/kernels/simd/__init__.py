"""Numbers side by side in a vector register: loading and storing, arithmetic, loops over points."""
