"""What runs over points and nodes, compiled: P2G, the grid update, walls, G2P, the stress update."""
