"""The command line: one file a command, with the parser, help, and options that they share."""
