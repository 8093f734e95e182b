"""A server of the Model Context Protocol (MCP) for one scene: any MCP client edits, looks, asks and undoes."""
