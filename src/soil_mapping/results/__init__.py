"""What a trial leaves: metrics, the folder, pictures, where it was computed; and how alike two studies are."""
