"""One run of a scene: its layout as flat arrays, the integration, the ledger and the result."""
