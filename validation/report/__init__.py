"""Results as JSON, JUnit, Markdown and self-contained pages, all through one pair of templates."""
