"""A page that plays a run in a browser: one file that loads nothing from elsewhere."""
