"""From a scene to flat arrays: tables of constants, slots of the state, contacts, and the start."""
