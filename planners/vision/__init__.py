"""Questions to vision-language models about rendered pictures, and their replies, which are checked before they count."""
