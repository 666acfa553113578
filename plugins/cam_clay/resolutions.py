"""With what cells, points and steps collapses of Cam Clay kept to an accuracy (docs/accuracy.md).

Overconsolidated clay softens as it fails, and its pile depends on the cells: it has none.
"""

from grainlaw.materials import Resolution

# By overconsolidation ratio.
MODIFIED_CAM_CLAY = {1.0: {"10%": Resolution(60, 16, 0.4, slenderness=1.0)}}
