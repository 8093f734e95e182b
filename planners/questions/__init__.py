"""Questions about a scene: read from words, answered from boxes, colours and relations."""
