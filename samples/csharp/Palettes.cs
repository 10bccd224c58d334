// SPDX-License-Identifier: MIT
// Stands for your animation system: reads the joints and palettes that write_palettes wrote.
using System.IO;
using System.Text;

public sealed class Palettes
{
    public readonly string[] Joints;
    public readonly float[] InverseBinds;  // 16 floats a joint, Columns4x4; so are the palettes
    public readonly float[] Rest;
    public readonly float[][] Frames;

    public Palettes(string path)
    {
        using (BinaryReader reader = new BinaryReader(File.OpenRead(path)))
        {
            Joints = new string[reader.ReadInt32()];
            Frames = new float[reader.ReadInt32()][];
            InverseBinds = new float[16 * Joints.Length];
            for (int i = 0; i < Joints.Length; ++i)
            {
                Joints[i] = Encoding.UTF8.GetString(reader.ReadBytes(reader.ReadInt32()));
                for (int k = 0; k < 16; ++k) InverseBinds[16 * i + k] = reader.ReadSingle();
            }
            Rest = Matrices(reader);
            for (int frame = 0; frame < Frames.Length; ++frame) Frames[frame] = Matrices(reader);
        }
    }

    float[] Matrices(BinaryReader reader)
    {
        float[] matrices = new float[16 * Joints.Length];
        for (int i = 0; i < matrices.Length; ++i) matrices[i] = reader.ReadSingle();
        return matrices;
    }
}
