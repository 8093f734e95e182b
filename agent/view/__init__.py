"""The scene in a browser: one session, served to tabs on this machine. docs/view-protocol.md tells what is sent."""
