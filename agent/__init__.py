"""Sessions on a scene, the chat, the command line, the pictures that both show, and the demo."""
