"""Questions to vision-language models about rendered pictures, and their replies, checked before they count."""
