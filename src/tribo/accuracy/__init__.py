"""From a wanted accuracy to a method and its settings, and from runs to error estimates."""
